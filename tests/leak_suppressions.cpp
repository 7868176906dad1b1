// Part of every test program that runs ONNX Runtime or OpenNI2.

/// LeakSanitizer asks for this: both keep some bytes of their own until the process ends.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libonnxruntime\nleak:libOpenNI2\nleak:OpenNI2/Drivers";
}
