#!/usr/bin/env bash
# Builds the module as a user does, but with less optimisation, in a virtual environment of its own, and tests it against the
# command: $PCS_SIM, or one built here.
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
venv="$CARGO_TARGET_DIR/python-tests"
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
export PATH="$venv/bin:$PATH" PIP_DISABLE_PIP_VERSION_CHECK=1
cargo fmt --package pcs-sim-python --check
cargo clippy --package pcs-sim-python -- -D warnings
pip install --quiet --require-virtualenv -r python/tests/requirements.txt
if [ -z "${PCS_SIM:-}" ]; then
    cargo build --release --bin pcs-sim
    PCS_SIM="$CARGO_TARGET_DIR/release/pcs-sim"
fi
export PCS_SIM
pip install --quiet --no-build-isolation --no-deps --force-reinstall -C build-args="--config '$PWD/python/tests/profile.toml'" ./python
cd python
ruff format --check .
ruff check .
mypy
python -m mypy.stubtest pcs_sim --mypy-config-file pyproject.toml --allowlist tests/stubtest_allowlist.txt --concise
python -m pytest "$@"
