#!/usr/bin/env bash
# Installs the build into a folder, moves it, compiles every header in it alone, builds docs/examples/cpp against it
# and runs both example and program.
# usage: install_test.sh SOURCE BUILD SCRATCH
set -euo pipefail
source=$1 build=$2 scratch=$3
fail() { echo "install_test: $*" >&2; exit 1; }
export MESA_SHADER_CACHE_DIR=$build/shader-cache LP_NUM_THREADS=1
unset POSEFUSION_MODEL_DIR LD_LIBRARY_PATH
rm -rf "$scratch" && mkdir -p "$scratch"

cmake --install "$build" --prefix "$scratch/first" >"$scratch/install.log" ||
    fail "cmake --install failed: $(tail -n 5 "$scratch/install.log")"
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix

for file in bin/posefusion include/posefusion/posefusion.hpp include/posefusion/engine/slam/slam.hpp \
    share/posefusion/models/movenet-multipose.onnx share/posefusion/shaders/map/splat.comp \
    share/posefusion/shaders/include/shared_types.h; do
    [[ -s $prefix/$file ]] || fail "$file is not installed"
done
if readelf -d "$prefix/bin/posefusion" "$prefix"/lib*/libposefusion.so | grep -E 'R(UN)?PATH' |
    grep -vF '[$ORIGIN'; then
    fail "an installed file looks for libraries in a folder of the build"
fi

build_against_it() { # source build [options]: a project of a user of the library
    local launcher=()
    command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    { cmake -S "$1" -B "$2" -DCMAKE_PREFIX_PATH="$prefix" "${launcher[@]}" "${@:3}" && cmake --build "$2" -j 2; } \
        >"$2.log" 2>&1 || { cat "$2.log" >&2; fail "$1 cannot be built"; }
}

# Public headers, all of them below include/posefusion, need nothing but each other, Eigen and the standard library.
[[ $(ls "$prefix/include") == posefusion ]] || fail "there are headers beside include/posefusion"
foreign=$(grep -rnE '^ *# *include' "$prefix/include" |
    grep -vE '#include <(posefusion/[a-z0-9_/]+\.hpp|Eigen/[A-Z][A-Za-z]+|[a-z_]+)>$' || true)
[[ -z $foreign ]] || fail "a public header needs what is not public: $foreign"
for internal in engine/vulkan/context.hpp engine/vulkan/kernel.hpp engine/map/surfel_map.hpp \
    engine/loops/back_end.hpp; do
    [[ -s $source/$internal ]] || fail "the test asks for $internal, which is no more"
    [[ ! -e $prefix/include/posefusion/$internal ]] || fail "$internal is installed"
done
build_against_it "$(dirname "$0")/headers" "$scratch/headers"

# The example, against what was installed and nothing else.
build_against_it "$source/docs/examples/cpp" "$scratch/example" -DCMAKE_CXX_FLAGS=-Werror
! grep -rqF "$source/engine" "$scratch/example"/CMakeFiles/example.dir ||
    fail "the example takes headers from the source folder"

"$prefix/bin/posefusion" synth --out "$scratch/recording" --frames 5 --people 1 --width 160 --height 120 >/dev/null
"$scratch/example/example" "$scratch/recording" "$scratch/example.txt" >"$scratch/example.out" ||
    fail "the example failed"
grep -q '^4 .* surfels$' "$scratch/example.out" ||
    fail "the example did not do five frames: $(cat "$scratch/example.out")"
"$prefix/bin/posefusion" run "$scratch/recording" --out "$scratch/run" --tracking-icp-max-distance 0.08 >/dev/null \
    2>"$scratch/run.err" || fail "the installed program failed: $(cat "$scratch/run.err")"
cmp "$scratch/example.txt" "$scratch/run/trajectory.txt" || fail "example and program differ"
grep -q 'Chart.js' "$scratch/run/report.html" || fail "the report lacks its plotting library"

# The benchmark, too, works from there, by the program beside it; without recordings it says what to give.
benchmark=$prefix/bin/posefusion-benchmark
(cd "$scratch" && "$benchmark" --synth "tiny=--frames 3 --people 1 --width 64 --height 48" --variants masks) \
    >"$scratch/table.md" 2>"$scratch/table.err" || fail "posefusion-benchmark: $(cat "$scratch/table.err")"
grep -qE '^\| tiny \| masks \| 3 \| [0-9.]+ \| 1\.00 \|' "$scratch/table.md" ||
    fail "posefusion-benchmark gives no table: $(cat "$scratch/table.md")"
[[ -s $scratch/benchmark/tiny/masks/seed_1/trajectory.txt ]] || fail "its runs are not in ./benchmark"
! "$benchmark" >/dev/null 2>"$scratch/no.err" || fail "posefusion-benchmark runs without recordings"
[[ $(wc -l <"$scratch/no.err") == 1 ]] && grep -q 'give --data, --synth or --tum' "$scratch/no.err" ||
    fail "without recordings it says: $(cat "$scratch/no.err")"

# It is the installed network that is used: without it the program says so and names that file.
model=$prefix/share/posefusion/models/movenet-multipose.onnx
echo "no network" >"$model"
for program in "$prefix/bin/posefusion run $scratch/recording --out $scratch/no" \
    "$scratch/example/example $scratch/recording $scratch/no.txt"; do
    ! $program >/dev/null 2>"$scratch/no.err" || fail "${program%% *} does not use the installed network"
    grep -qF "$model" "$scratch/no.err" || fail "no word of the installed network: $(cat "$scratch/no.err")"
done
rm -rf "$scratch"
