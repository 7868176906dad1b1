#!/usr/bin/env bash
# Installs the build into a folder, moves that folder, builds docs/examples/cpp against it and runs both example and program.
# usage: install_test.sh SOURCE BUILD SCRATCH
set -euo pipefail
source=$1 build=$2 scratch=$3
fail() { echo "install_test: $*" >&2; exit 1; }
export MESA_SHADER_CACHE_DIR=$build/shader-cache LP_NUM_THREADS=1
unset POSEFUSION_MODEL_DIR LD_LIBRARY_PATH
rm -rf "$scratch" && mkdir -p "$scratch"

cmake --install "$build" --prefix "$scratch/first" >"$scratch/install.log" || fail "cmake --install failed: $(tail -n 5 "$scratch/install.log")"
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix

for file in bin/posefusion include/posefusion/engine/slam/slam.hpp include/posefusion/hosts/pipeline/frame_by_frame.hpp \
    share/posefusion/models/movenet-multipose.onnx share/posefusion/shaders/map/splat.comp share/posefusion/shaders/include/shared_types.h; do
    [[ -s $prefix/$file ]] || fail "$file is not installed"
done
if readelf -d "$prefix/bin/posefusion" "$prefix"/lib*/libposefusion.so | grep -E 'R(UN)?PATH' | grep -vF '[$ORIGIN'; then
    fail "an installed file looks for libraries in a folder of the build"
fi

# The example, against what was installed and nothing else.
launcher=() ; command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
cmake -S "$source/docs/examples/cpp" -B "$scratch/example" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_FLAGS=-Werror "${launcher[@]}" \
    >"$scratch/example.log" 2>&1 && cmake --build "$scratch/example" >>"$scratch/example.log" 2>&1 ||
    { cat "$scratch/example.log" >&2; fail "the example cannot be built"; }
! grep -rqF "$source/engine" "$scratch/example"/CMakeFiles/example.dir || fail "the example takes headers from the source folder"

"$prefix/bin/posefusion" synth --out "$scratch/recording" --frames 5 --people 1 --width 160 --height 120 >/dev/null
"$scratch/example/example" "$scratch/recording" "$scratch/example.txt" >"$scratch/example.out" || fail "the example failed"
grep -q '^4 .* surfels$' "$scratch/example.out" || fail "the example did not do five frames: $(cat "$scratch/example.out")"
"$prefix/bin/posefusion" run "$scratch/recording" --out "$scratch/run" --tracking-icp-max-distance 0.08 >/dev/null 2>"$scratch/run.err" ||
    fail "the installed program failed: $(cat "$scratch/run.err")"
cmp "$scratch/example.txt" "$scratch/run/trajectory.txt" || fail "example and program differ"
grep -q 'Chart.js' "$scratch/run/report.html" || fail "the report lacks its plotting library"

# It is the installed network that is used: without it the program says so and names that file.
model=$prefix/share/posefusion/models/movenet-multipose.onnx
echo "no network" >"$model"
for program in "$prefix/bin/posefusion run $scratch/recording --out $scratch/no" "$scratch/example/example $scratch/recording $scratch/no.txt"; do
    ! $program >/dev/null 2>"$scratch/no.err" || fail "${program%% *} does not use the installed network"
    grep -qF "$model" "$scratch/no.err" || fail "no word of the installed network: $(cat "$scratch/no.err")"
done
rm -rf "$scratch"
