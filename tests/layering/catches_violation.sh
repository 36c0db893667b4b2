#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# catches_violation.sh CHECK: the check is worth something only when it goes red on a seeded violation.
set -u
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{common/{config,core,geometry,image,profile,rt,stripe,time},firmware/app,tests} \
  "$tree"/hal/{api,board,linux,replay,sim,timing} \
  "$tree"/host/{apps/{biteline-host,biteline-web},bite_line/published,calibration,cloud,fleet,geometry,intake,report,second_look,study,transfer} \
  "$tree"/host/interfaces/{accounts,api,control,line_control} "$tree"/host/records/{archive,digest,memory,results} "$tree"/host/robot/{kinematics,link,path}
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
# Each folder that a rule names: gone, and the check says its name.
for folder in hal/sim host/study host/interfaces/accounts host/robot/link host/records/results; do
  mv "$tree/$folder" "$tree/gone"
  if told=$("$1" "$tree") || ! grep -q "names $folder" <<<"$told"; then
    echo "green although $folder does not exist"
    exit 1
  fi
  mv "$tree/gone" "$tree/$folder"
done
