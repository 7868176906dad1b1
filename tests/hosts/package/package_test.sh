#!/usr/bin/env bash
# Makes the Debian package of the build, looks into it, unpacks it and works with what is there.
# usage: package_test.sh BUILD SCRATCH
set -euo pipefail
build=$1 scratch=$2
fail() { echo "package_test: $*" >&2; exit 1; }
command -v dpkg-deb >/dev/null || { echo "package_test: no dpkg-deb here, nothing tested"; exit 0; }
export MESA_SHADER_CACHE_DIR=$build/shader-cache LP_NUM_THREADS=1
unset POSEFUSION_MODEL_DIR LD_LIBRARY_PATH PYTHONPATH
rm -rf "$scratch" && mkdir -p "$scratch"

cpack --config "$build/CPackConfig.cmake" -B "$scratch/cpack" >"$scratch/cpack.log" 2>&1 ||
    { cat "$scratch/cpack.log" >&2; fail "cpack failed"; }
package=$(echo "$scratch"/cpack/posefusion_*.deb)
[[ -s $package ]] || fail "there is no package: $(cat "$scratch/cpack.log")"

# What it needs: the libraries by their Debian packages, a Vulkan driver; ONNX Runtime is inside.
depends=$(dpkg-deb -f "$package" Depends)
for needed in libc6 libvulkan1 libopencv-core libpcl-surface libyaml-cpp libembree3 libcpp-httplib \
    'mesa-vulkan-drivers | vulkan-icd'; do
    [[ $depends == *$needed* ]] || fail "it does not depend on $needed: $depends"
done
[[ $depends != *onnx* ]] || fail "Debian has no such package: $depends"
[[ $(dpkg-deb -f "$package" Package) == posefusion && -n $(dpkg-deb -f "$package" Version) ]] ||
    fail "it has no name or version"
authors=$(sed -n 's/^  - name: //p' "$(dirname "$0")/../../../CITATION.cff")
[[ -n $authors && $(dpkg-deb -f "$package" Maintainer) == "$authors" ]] ||
    fail "it is by '$(dpkg-deb -f "$package" Maintainer)', not by '$authors'"

dpkg-deb -c "$package" | awk '{ print $6 }' >"$scratch/content"
for file in bin/posefusion bin/posefusion-benchmark libexec/posefusion/evaluate_map \
    share/posefusion/tools/benchmark share/posefusion/tools/benchmarking/published.json \
    lib/posefusion/libonnxruntime.so.1 share/posefusion/models/movenet-multipose.onnx \
    share/man/man1/posefusion.1.gz share/bash-completion/completions/posefusion \
    share/applications/posefusion.desktop share/icons/hicolor/scalable/apps/posefusion.svg \
    lib/cmake/PoseFusion/PoseFusionConfig.cmake \
    include/posefusion/posefusion.hpp include/posefusion/engine/slam/slam.hpp \
    share/posefusion/threejs/three.module.min.js share/doc/posefusion/LICENSE.threejs \
    share/doc/posefusion/copyright share/doc/posefusion/LICENSE.onnxruntime; do
    grep -qxF "./usr/$file" "$scratch/content" || fail "/usr/$file is missing"
done
for link in $(grep -oE '\]\([A-Za-z][^:)#]+' "$(dirname "$0")/../../../README.md" | cut -c3- | grep -v '^http'); do
    grep -qxF "./usr/share/doc/posefusion/$link" "$scratch/content" || fail "README.md leads to $link, which is missing"
done
headers=$(grep -E '^\./usr/include/' "$scratch/content" | grep -vE '^\./usr/include/(posefusion/.*)?$' || true)
[[ -z $headers ]] || fail "it has headers beside /usr/include/posefusion: $headers"
! grep -qvE '^\./(usr/.*)?$' "$scratch/content" ||
    fail "it writes outside /usr: $(grep -vE '^\./(usr/.*)?$' "$scratch/content" | head -3)"

dpkg-deb -x "$package" "$scratch/unpacked"
dpkg-deb -e "$package" "$scratch/control"
if [[ -d $scratch/unpacked/usr/lib/python3/dist-packages/posefusion ]]; then
    grep -qx 'rm -rf "/usr/lib/python3/dist-packages/posefusion/__pycache__"' "$scratch/control/prerm" ||
        fail "it leaves compiled Python behind"
    [[ -x $scratch/control/prerm ]] || fail "prerm cannot be run"
fi
usr=$scratch/unpacked/usr program=$scratch/unpacked/usr/bin/posefusion
ldd "$program" "$usr"/lib/libposefusion.so.* >"$scratch/ldd"
grep -F libonnxruntime.so.1 "$scratch/ldd" | grep -vqF "$usr/" &&
    fail "ONNX Runtime is taken from elsewhere: $(grep onnx "$scratch/ldd")"
! grep -F 'not found' "$scratch/ldd" || fail "a library is not found"
if "$program" --version | grep -q '^with video'; then
    grep -qxF ./usr/lib/posefusion/libposefusion_video.so "$scratch/content" ||
        fail "it says that it has video, and lacks it"
fi

# The software driver it carries is offered beside those of the system, and can be loaded.
if [[ -e $(dirname "$0")/../../../.deps/driver/lvp_icd.json ]]; then
    manifest=$usr/share/posefusion/driver/lvp_icd.json
    [[ -s $manifest && -s $usr/share/doc/posefusion/LICENSE.mesa ]] ||
        fail "the software driver or its licence is missing"
    (unset VK_DRIVER_FILES VK_ICD_FILENAMES; "$program" devices) >"$scratch/devices" || fail "devices failed"
    VK_DRIVER_FILES=$manifest "$program" devices >"$scratch/own" || fail "its software driver cannot be loaded"
    newest=$(grep -o 'Mesa [0-9.]*' "$scratch/own" | head -n 1)
    grep -q "^Without --device.*$newest" "$scratch/devices" ||
        fail "it does not take its own driver: $(cat "$scratch/devices")"
fi

# It works from there.
"$program" --help >"$scratch/help"
"$program" synth --out "$scratch/recording" --frames 4 --people 1 --width 160 --height 120 >/dev/null
"$program" run "$scratch/recording" --out "$scratch/run" --all-surfels >/dev/null 2>"$scratch/run.err" ||
    fail "run: $(cat "$scratch/run.err")"
"$program" export "$scratch/run" --cloud "$scratch/room.pcd" --html "$scratch/room.html" >/dev/null 2>&1 ||
    fail "export failed"
grep -q '"three":"data:text/javascript;base64,' "$scratch/room.html" || fail "the web page lacks three.js"
[[ $(grep -vc '^#' "$scratch/run/trajectory.txt") == 4 && -s $scratch/room.pcd ]] || fail "the run is incomplete"

# So does the benchmark, with ghosts (evaluate_map), plots (Chart.js) and what compares with the published figures.
benchmark=$usr/bin/posefusion-benchmark
"$benchmark" --help >"$scratch/benchmark_help" && grep -q '^usage: posefusion-benchmark' "$scratch/benchmark_help" ||
    fail "posefusion-benchmark --help: $(cat "$scratch/benchmark_help")"
"$benchmark" --synth "tiny=--frames 6 --people 1 --width 64 --height 48" --seeds 2 --variants masks \
    --out "$scratch/benchmark" -- --all-surfels >"$scratch/table.md" 2>"$scratch/table.err" ||
    fail "posefusion-benchmark: $(cat "$scratch/table.err")"
ghosts=$(awk -F ' *[|] *' '$2 == "recording" { for (i = 1; i <= NF; i++) if ($i == "ghosts %") column = i }
    $2 == "tiny" { print $column }' "$scratch/table.md")
[[ $ghosts =~ ^[0-9.]+\ ± ]] || fail "posefusion-benchmark counts no ghosts: $(cat "$scratch/table.md")"
grep -q 'Chart.js v' "$scratch/benchmark/page.html" || fail "the page of posefusion-benchmark lacks its plots"
! "$benchmark" --tum "$scratch/recording" >/dev/null 2>"$scratch/tum.err" || fail "a recording passes for TUM's"
grep -q "none of TUM's recordings is there" "$scratch/tum.err" || fail "--tum: $(cat "$scratch/tum.err")"
left=$(find "$usr" -name __pycache__)
[[ -z $left ]] || fail "posefusion-benchmark leaves behind $left"

# The manual page describes every command and every option.
gzip -dc "$usr/share/man/man1/posefusion.1.gz" | sed 's/\\-/-/g' >"$scratch/manual"
commands=$(awk '/^Subcommands:/ { on = 1; next } !NF { on = 0 } on { print $1 }' "$scratch/help")
[[ $(wc -w <<<"$commands") -ge 6 ]] || fail "the help lists no commands"
for command in $commands; do
    grep -qx ".SH \"${command^^}\"" "$scratch/manual" || fail "the manual page lacks $command"
    for option in $("$program" "$command" --help-all | grep -oE '^  --[a-z0-9-]+'); do
        grep -qE -- "^\.B $option( |$)" "$scratch/manual" || fail "the manual page lacks $command $option"
    done
done
basic=$(grep -n '^\.B --scale' "$scratch/manual" | head -1 | cut -d: -f1)
advanced=$(grep -n '^\.SS "Advanced' "$scratch/manual" | head -1 | cut -d: -f1)
grep -q '^\.B posefusion-benchmark' "$scratch/manual" || fail "the manual page is silent about posefusion-benchmark"
[[ -n $basic && -n $advanced && $basic -lt $advanced ]] || fail "basic options do not come first in the manual page"
! grep -qaP '[\x00-\x08]' "$scratch/manual" || fail "the manual page has bytes that are no text"
if command -v groff >/dev/null; then
    warnings=$(groff -man -Tutf8 -ww <(gzip -dc "$usr/share/man/man1/posefusion.1.gz") 2>&1 >/dev/null |
        grep -v "can't break line\|cannot adjust" || true)
    [[ -z $warnings ]] || fail "the manual page has faults: $warnings"
fi

# Completion, as bash asks for it.
complete_words() {
    bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _posefusion; echo " ${COMPREPLY[*]} "' - \
        "$usr/share/bash-completion/completions/posefusion" "$program" "$@"
}
[[ $(complete_words ev) == " evaluate " ]] || fail "ev is completed to '$(complete_words ev)'"
[[ $(complete_words run "" --no-rep) == " --no-report " ]] ||
    fail "run --no-rep is completed to '$(complete_words run "" --no-rep)'"
[[ $(complete_words run "" --tracking-icp-r) == " --tracking-icp-robust " ]] ||
    fail "advanced options are not completed"
[[ $(complete_words synth --sc) == " --scenario " ]] || fail "synth --sc is completed to '$(complete_words synth --sc)'"
[[ $(complete_words run /) == "  " ]] || fail "file names are not left to bash"

grep -qx 'Exec=posefusion view %f' "$usr/share/applications/posefusion.desktop" ||
    fail "the desktop file starts something else"
if command -v desktop-file-validate >/dev/null; then
    desktop-file-validate "$usr/share/applications/posefusion.desktop" || fail "the desktop file has faults"
fi
if compgen -G "$usr/lib/python3/dist-packages/posefusion/_core.*.so" >/dev/null; then
    PYTHONPATH=$usr/lib/python3/dist-packages /usr/bin/python3 -B -c 'import posefusion; posefusion.Detector()' ||
        fail "import posefusion failed"
fi
rm -rf "$scratch"
