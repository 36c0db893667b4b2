#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# api_answers.sh OPENAPI TEST...: runs the tests, and holds each answer of the API that they note against OPENAPI.
set -euo pipefail
openapi=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export BITELINE_API_ANSWERS=$folder/answers
for test in "$@"; do
  # Of the service and the web program only what asks the API.
  case "$(basename "$test")" in
    service_test) "$test" -g OperatorControlAnswers ;;
    web_test) "$test" -g WebServer ;;
    *) "$test" ;;
  esac
done
"$(dirname "${BASH_SOURCE[0]}")/check_api_answers.py" "$openapi" "$folder/answers" --every
