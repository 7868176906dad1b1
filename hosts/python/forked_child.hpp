#pragma once

namespace posefusion::python {

/// To be called before threads are made. Children that the process forks from now on have none of these threads, and
/// what waits for them at the end of a process (ONNX Runtime, the Vulkan driver) would wait for ever: such a child ends
/// without the destructors of libraries.
void prepare_for_forks();

}  // namespace posefusion::python
