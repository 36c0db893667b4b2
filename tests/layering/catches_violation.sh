#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# catches_violation.sh CHECK: the check is worth something only when it goes red on a seeded violation.
set -u
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{common/core,hal/api,hal/board,firmware/app,host/bite_line,host/records/{digest,memory}}
echo '#include "common/core/result.hpp"' >"$tree/host/bite_line/good.cpp"
echo '#include "host/records/digest/digest.hpp"' >"$tree/host/bite_line/allowed.cpp"
"$1" "$tree" >/dev/null || { echo "red on a clean tree"; exit 1; }
for seed in 'common/core/a.hpp hal/api/frame.hpp' 'host/bite_line/b.cpp hal/api/frame.hpp' 'host/bite_line/c.cpp host/robot/link/link.hpp' \
  'host/bite_line/h.cpp host/interfaces/api/api.hpp' 'host/bite_line/i.cpp host/records/memory/memory.hpp' \
  'host/bite_line/g.cpp host/bite_line/published/p.hpp' \
  'hal/api/d.hpp firmware/app/x.hpp' 'hal/board/e.hpp hal/linux/gpiod/gpiod_line.hpp' \
  'firmware/app/f.cpp gpiod.h'; do
  set -- "$1" $seed
  echo "#include \"$3\"" >"$tree/$2"
  if "$1" "$tree" >/dev/null; then
    echo "green although $2 includes $3"
    exit 1
  fi
  rm "$tree/$2"
done
