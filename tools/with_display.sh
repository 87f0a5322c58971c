#!/usr/bin/env bash
# Runs a command with something to draw on: the display there is, or else an invisible one with software OpenGL.
#
#   tools/with_display.sh build/release/bin/carom run teapots --picture out/picture.png
#
# Without Xvfb the command runs all the same; programs that draw say themselves that there is no display.
set -eu
if [ -n "${DISPLAY:-}" ] || ! command -v xvfb-run >/dev/null; then
    exec "$@"
fi
export LIBGL_ALWAYS_SOFTWARE=1
exec xvfb-run -a -s "-screen 0 1280x1024x24" "$@"
