#include "tests/ui/file_drop.h"

#include <chrono>
#include <cstring>
#include <thread>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace relume {
namespace {

constexpr long kVersion = 5;

/// A source of one drag, https://www.freedesktop.org/wiki/Specifications/XDND
class Source {
public:
    Source(Display* display, Window target)
        : display_(display), target_(target),
          window_(XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0)) {}
    ~Source() { XDestroyWindow(display_, window_); }

    bool drop(const std::string& uri) {
        XSetSelectionOwner(display_, atom("XdndSelection"), window_, CurrentTime);
        send("XdndEnter", kVersion << 24, static_cast<long>(atom("text/uri-list")), 0, 0);
        send("XdndPosition", 0, (100 << 16) | 100, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
        bool dropped = false;
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (std::chrono::steady_clock::now() < end) {
            if (XPending(display_) == 0) {
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
                continue;
            }
            XEvent event;
            XNextEvent(display_, &event);
            if (event.type == SelectionRequest) {
                answer(event.xselectionrequest, uri);
            } else if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished")) {
                return true;
            } else if (event.type == ClientMessage && event.xclient.message_type == atom("XdndStatus")) {
                if (!dropped) send("XdndDrop", 0, CurrentTime, 0, 0);
                dropped = true;
            }
        }
        return false;
    }

private:
    Atom atom(const char* name) { return XInternAtom(display_, name, False); }

    void send(const char* message, long a, long b, long c, long d) {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = target_;
        event.xclient.message_type = atom(message);
        event.xclient.format = 32;
        event.xclient.data.l[0] = static_cast<long>(window_);
        event.xclient.data.l[1] = a;
        event.xclient.data.l[2] = b;
        event.xclient.data.l[3] = c;
        event.xclient.data.l[4] = d;
        XSendEvent(display_, target_, False, NoEventMask, &event);
        XFlush(display_);
    }

    void answer(const XSelectionRequestEvent& request, const std::string& uri) {
        XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(uri.data()), static_cast<int>(uri.size()));
        XEvent reply{};
        reply.xselection.type = SelectionNotify;
        reply.xselection.requestor = request.requestor;
        reply.xselection.selection = request.selection;
        reply.xselection.target = request.target;
        reply.xselection.property = request.property;
        reply.xselection.time = request.time;
        XSendEvent(display_, request.requestor, False, NoEventMask, &reply);
        XFlush(display_);
    }

    Display* display_;
    Window target_, window_;
};

} // namespace

bool dropFile(const std::string& display, unsigned long window, const std::string& path) {
    Display* connection = XOpenDisplay(display.c_str());
    if (connection == nullptr) return false;
    const bool taken = Source(connection, window).drop("file://" + path + "\r\n");
    XCloseDisplay(connection);
    return taken;
}

bool setDots(const std::string& name, int dots) {
    Display* display = XOpenDisplay(name.c_str());
    if (display == nullptr) return false;
    const std::string resources = "Xft.dpi:\t" + std::to_string(dots) + "\n";
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(resources.data()),
                    static_cast<int>(resources.size()));
    XCloseDisplay(display);
    return true;
}

} // namespace relume
