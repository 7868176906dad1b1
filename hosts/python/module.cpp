#include "engine/core/error.hpp"
#include "hosts/library/version.hpp"
#include "hosts/python/bindings.hpp"
#include "hosts/python/unlocked.hpp"

namespace posefusion::python {

PYBIND11_MODULE(_core, module) {
    module.attr("__version__") = version();
    py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
    finish_calls_at_exit();
    define_recording(module);
    define_posefusion(module);
    define_people(module);
    define_evaluation(module);
}

}  // namespace posefusion::python
