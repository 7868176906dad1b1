#pragma once
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <X11/keysym.h>
#include <unistd.h>

#include <string>

namespace posefusion::test {

/// Sits before a display: presses keys, moves the mouse and closes windows as a person does.
class DesktopUser {
public:
    explicit DesktopUser(const std::string& display) : display_(XOpenDisplay(display.c_str())) {}
    ~DesktopUser() {
        if (display_ != nullptr) XCloseDisplay(display_);
    }
    DesktopUser(const DesktopUser&) = delete;
    DesktopUser& operator=(const DesktopUser&) = delete;

    /// Waits until a window of that title is there. @return false after ten seconds
    bool find(const std::string& title) {
        if (display_ == nullptr) return false;
        for (int i = 0; i < 1000; ++i) {
            window_ = search(title);
            if (window_ != 0) return true;
            usleep(10'000);
        }
        return false;
    }

    void press(KeySym key) const {
        const KeyCode code = XKeysymToKeycode(display_, key);
        XTestFakeKeyEvent(display_, code, True, CurrentTime);
        XTestFakeKeyEvent(display_, code, False, CurrentTime);
        settle();
    }
    /// To pixels of the display.
    void move(int x, int y) const {
        XTestFakeMotionEvent(display_, -1, x, y, CurrentTime);
        settle();
    }
    /// @param button  1 left, 2 middle, 3 right, 4 wheel up, 5 wheel down
    void hold(unsigned button) const {
        XTestFakeButtonEvent(display_, button, True, CurrentTime);
        settle();
    }
    void release(unsigned button) const {
        XTestFakeButtonEvent(display_, button, False, CurrentTime);
        settle();
    }
    void resize(unsigned width, unsigned height) const {
        XResizeWindow(display_, window_, width, height);
        settle();
    }
    /// As a window manager does when its cross is clicked.
    void close() const {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = window_;
        event.xclient.message_type = XInternAtom(display_, "WM_PROTOCOLS", False);
        event.xclient.format = 32;
        event.xclient.data.l[0] = static_cast<long>(XInternAtom(display_, "WM_DELETE_WINDOW", False));
        XSendEvent(display_, window_, False, NoEventMask, &event);
        settle();
    }

private:
    [[nodiscard]] ::Window search(const std::string& title) const {
        ::Window root = 0, parent = 0, *children = nullptr, found = 0;
        unsigned count = 0;
        if (XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count) == 0) return 0;
        for (unsigned i = 0; i < count; ++i) {
            char* name = nullptr;
            if (XFetchName(display_, children[i], &name) != 0 && name == title) found = children[i];
            if (name != nullptr) XFree(name);
        }
        if (children != nullptr) XFree(children);
        return found;
    }
    void settle() const {
        XSync(display_, False);
        usleep(100'000);
    }

    Display* display_;
    ::Window window_ = 0;
};

}  // namespace posefusion::test
