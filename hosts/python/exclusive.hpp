#pragma once
#include <unistd.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/python/forked_child.hpp"
#include "hosts/python/unlocked.hpp"

namespace posefusion::python {

/// An object with which several threads of Python work by turns, without the GIL. It has threads or memory of a
/// device, which a forked child of the process does not have: there it can be neither used nor destroyed.
template <class Object>
class Exclusive {
public:
    /// @param name  of its class, for messages  @param make  returns a std::unique_ptr<Object>
    template <class Make>
    Exclusive(const char* name, Make&& make) : name_(name) {
        prepare_for_forks();
        const Unlocked unlocked;
        object_ = make();
    }
    ~Exclusive() {
        if (in_child()) (void)object_.release();
    }
    Exclusive(const Exclusive&) = delete;
    Exclusive& operator=(const Exclusive&) = delete;

    /// `call`, with the object. Throws what it throws, and Error in a forked child.
    template <class Call>
    auto use(Call&& call) {
        if (in_child())
            throw Error("this " + name_ + " was made before the process forked; make one of its own in the child");
        const Unlocked unlocked;
        const std::lock_guard lock(mutex_);
        return call(*object_);
    }

private:
    [[nodiscard]] bool in_child() const { return getpid() != process_; }

    std::string name_;
    pid_t process_ = getpid();
    std::mutex mutex_;
    std::unique_ptr<Object> object_;
};

}  // namespace posefusion::python
