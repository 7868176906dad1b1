// Part of every test program that runs ONNX Runtime.

/// LeakSanitizer asks for this: ONNX Runtime keeps a few hundred bytes of its own until the process ends.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libonnxruntime"; }
