#!/usr/bin/env bash
# Makes the Python wheel, looks into it, installs it into a fresh virtual environment and works with it there.
# usage: wheel_test.sh SOURCE BUILD PYTHON SCRATCH
set -euo pipefail
source=$1 build=$2 python=$3 scratch=$4
fail() { echo "wheel_test: $*" >&2; exit 1; }
nothing_tested() { echo "wheel_test: $*, nothing tested"; exit 0; }
command -v patchelf >/dev/null || nothing_tested "no patchelf here"
"$python" -c 'import ensurepip, venv' 2>/dev/null || nothing_tested "no python3-venv here"
export MESA_SHADER_CACHE_DIR=$build/shader-cache LP_NUM_THREADS=1 PIP_DISABLE_PIP_VERSION_CHECK=1
unset POSEFUSION_MODEL_DIR LD_LIBRARY_PATH PYTHONPATH VK_DRIVER_FILES VK_ICD_FILENAMES
rm -rf "$scratch" && mkdir -p "$scratch"

cmake --build "$build" --target wheel >"$scratch/wheel.log" 2>&1 || { cat "$scratch/wheel.log" >&2; fail "no wheel"; }
wheel=$(echo "$build"/wheel/posefusion-*.whl)
[[ $wheel =~ -cp3[0-9]+-cp3[0-9]+-manylinux_2_[0-9]+_$(uname -m)\.whl$ ]] || fail "$wheel: what is it for?"

# What it carries: the network, the libraries and a note on the licence of each, nothing under the GPL alone.
"$python" -m zipfile -l "$wheel" | awk '{ print $1 }' >"$scratch/content"
for file in posefusion/lib/libonnxruntime.so.1 posefusion/lib/libvulkan.so.1 \
    posefusion/share/posefusion/models/movenet-multipose.onnx; do
    grep -qxF "$file" "$scratch/content" || fail "$file is missing"
done
! grep -E '/lib(gdal|poppler|avcodec|avformat|x26[45]|mariadb|readline|gnutls)' "$scratch/content" ||
    fail "it carries a library of imgcodecs"
"$python" -m zipfile -e "$wheel" "$scratch/unpacked"
licences=$(echo "$scratch"/unpacked/posefusion-*.dist-info/licenses)
for library in "$scratch"/unpacked/posefusion/lib/*; do
    name=$(basename "$library")
    [[ $name =~ ^lib(posefusion|onnxruntime|vulkan_lvp|opencv_imgcodecs|jbig) ]] && continue
    grep -qF "$name" "$licences/LIBRARIES" || fail "$name has no licence"
done
rm -rf "$scratch/unpacked"

# Installed, with the system's NumPy: there is no network in a test.
"$python" -m venv --system-site-packages "$scratch/venv"
"$scratch/venv/bin/python" -m pip install --quiet --no-deps --no-index "$wheel" || fail "pip does not install it"
"$build/posefusion" synth --out "$scratch/recording" --frames 2 --people 1 --width 160 --height 120 >/dev/null 2>&1
cp "$source/docs/examples/python/example.py" "$scratch"
cat >"$scratch/elsewhere.py" <<'EOF'
import sys, posefusion
frames = [rgb for _, rgb, _ in posefusion.Recording("recording")]
slam = posefusion.PoseFusion(posefusion.Recording("recording").camera, {"segmentation": {"mode": "paper"}})
for stamp, rgb, depth in posefusion.Recording("recording"):
    slam.process(rgb, depth, stamp)
assert len(frames) == 2 and frames[0].any()
mapped = {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
print(*sorted(file for file in mapped if file.startswith(sys.argv[1]) or "opencv" in file or "pcl" in file))
EOF
cd "$scratch"
venv/bin/python example.py >example.out || fail "the example failed"
grep -qE '^ok camera at' example.out && grep -qE '^[1-9][0-9]+ surfels' example.out || fail "$(cat example.out)"
venv/bin/python elsewhere.py "$build" >mapped || fail "a recording cannot be read"
! tr ' ' '\n' <mapped | grep -v "^$scratch/venv/" || fail "libraries are taken from outside the wheel"
rm -rf "$scratch"
