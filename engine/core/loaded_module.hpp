#pragma once
#include <dlfcn.h>

#include <filesystem>
#include <string>

#include "engine/core/error.hpp"

namespace posefusion {

/// A function of a module: a shared library that only few runs need and that takes long to load, with all it depends
/// on. It is loaded at the first call, from where the program or library of the caller looks for its own libraries
/// ($ORIGIN), or from `built`, its place in the build tree. Throws Error.
template <class Function>
[[nodiscard]] Function* function_of_module(const std::filesystem::path& built, const char* function) {
    void* module = dlopen(built.filename().c_str(), RTLD_NOW);
    if (module == nullptr) module = dlopen(built.c_str(), RTLD_NOW);
    void* const found = module == nullptr ? nullptr : dlsym(module, function);
    if (found == nullptr) {
        const char* const reason = dlerror();
        throw Error("a part of PoseFusion cannot be loaded (" + std::string(reason == nullptr ? "" : reason) +
                    "); install it again");
    }
    return reinterpret_cast<Function*>(found);
}

}  // namespace posefusion
