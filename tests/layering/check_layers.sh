#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_layers.sh ROOT: every #include "layer/..." stays within what its layer may know.
#   common <- hal <- firmware, common <- host; inside host the algorithms know neither intake, robot/link, interfaces, fleet nor apps,
#   and of the records two tools alone: archive and digest;
#   vendor headers stay out of hal/api and of common (but for common/config and common/image).
# A rule that names a folder which does not exist is red, too: it would hold nothing.
set -u
root=$1
bad=0

# exist PLACE...: each is there, below the root.
exist() {
  local place
  for place in "$@"; do
    [ -e "$root/$place" ] && continue
    echo "layering: a rule names $place, which does not exist: name it in check_layers.sh as it is called now"
    bad=1
  done
}

# forbid FOLDERS PATTERN WHY: no file below FOLDERS includes what PATTERN (an extended regular expression) names.
# A PATTERN that ends in / names folders of this tree: a(b|c)/ is ab/ and ac/.
forbid() {
  local found
  exist $1
  case $2 in */) exist $(eval "echo $(tr '(|)' '{,}' <<<"$2")") ;; esac
  found=$(cd "$root" && grep -rnE --include='*.hpp' --include='*.cpp' "^[[:space:]]*#[[:space:]]*include [\"<]($2)" $1 2>/dev/null)
  if [ -n "$found" ]; then
    echo "layering: $3"
    echo "$found"
    bad=1
  fi
}

forbid common '(hal|firmware|host|tests)/' 'common knows no other layer'
forbid hal '(firmware|host|tests)/' 'hal knows common only'
forbid firmware '(host|tests)/' 'firmware knows common and hal'
forbid host '(hal|firmware|tests)/' 'host knows common only: sensor and robot are network peers'
forbid 'hal/api hal/board hal/timing' 'hal/(linux|replay|sim)/' 'interfaces, board data and arithmetic know no backend'
forbid host/fleet 'host/(intake|robot|interfaces/(api|accounts)|records/results|apps)/' 'the fleet knows the memory, not the cell'
forbid 'common firmware hal host/records/memory host/interfaces/api host/interfaces/control host/apps/biteline-host host/apps/biteline-web' '(mosquitto|pqxx)' 'the cell waits for no network: broker and database are reached by host/fleet alone'
forbid host/interfaces/line_control 'host/(intake|robot|interfaces/(api|accounts)|records/(memory|results)|apps)/' 'the state machine of the line knows no door and no memory'
kept=$(cd "$root" && ls host/records 2>/dev/null | grep -vE '^(archive|digest)$|\.' | paste -sd'|')
for algorithm in geometry cloud bite_line calibration transfer second_look study robot/kinematics robot/path report; do
  forbid "host/$algorithm" 'host/(intake|robot/link|interfaces|fleet|apps)/' 'algorithms know neither the network nor the programs'
  forbid "host/$algorithm" "host/records/($kept)/" 'algorithms know nothing that is kept: of the records archive and digest alone'
done
product="host/cloud host/intake host/transfer host/records $(cd "$root" && ls -d host/bite_line/* | grep -v '/published$')"
forbid "$product" 'host/bite_line/published/' 'the product does not stand on the published method'
forbid 'common firmware host hal/api hal/board hal/timing hal/replay hal/sim' '(gpiod\.h|linux/gpio\.h)' 'lines of GPIO chips are reached by hal/linux/gpiod alone'
forbid hal/api '(linux|gpiod|arv|aravis|embree)' 'no vendor header in hal/api'
forbid 'common/core common/time common/geometry common/profile common/rt common/stripe' '(yaml-cpp|spng|opencv2|zmq|sys/|linux/)' \
  'the inner modules of common know no library beyond Eigen and Highway, and no operating system'
exit $bad
