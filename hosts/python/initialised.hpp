#pragma once
#include <pybind11/pybind11.h>

#include <type_traits>

/// Objects that were made by Class.__new__(Class) and never got their __init__(): pybind11 would hand out memory that
/// nobody has initialised.
namespace posefusion::python {

/// True for our classes that Python knows: their objects are refused as arguments, self among them, until they are
/// initialised.
template <class Class>
inline constexpr bool kKnownToPython = false;

}  // namespace posefusion::python

namespace pybind11::detail {

template <class Class>
class type_caster<Class, std::enable_if_t<posefusion::python::kKnownToPython<Class>>> : public type_caster_base<Class> {
public:
    bool load(handle source, bool convert) {
        const type_info* type = this->typeinfo;
        if (type != nullptr && isinstance(source, reinterpret_cast<PyObject*>(type->type))) {
            auto* object = reinterpret_cast<instance*>(source.ptr());
            if (!object->get_value_and_holder(type).holder_constructed())
                throw type_error(str("{}.__init__() has not been called for this object").format(type->type->tp_name));
        }
        return type_caster_base<Class>::load(source, convert);
    }
};

}  // namespace pybind11::detail
