#!/usr/bin/env bash
# Takes docs/lab.png, the README's first picture, in a browser (Chromium).
set -euo pipefail
cd "$(dirname "$0")/.."
BROWSER_REQUIRED=1 cargo test --release --test it -- --ignored the_readmes_picture_is_taken
