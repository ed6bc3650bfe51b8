#include "app/viewer/window/gui.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui_internal.h>

namespace relume {
namespace {

constexpr float kFontPixels = 15, kBuiltInPixels = 13; // at scale 1; ImGui's own is a bitmap of 13
constexpr float kTitle = 1.6f;                         // size of headings, as a share of the text's

// Most systems have one of these outline fonts; ImGui's own letters are a bitmap, which is coarse when
// enlarged.
constexpr std::array kFonts = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
};

// Names of lights, objects and files may be in any language: the fonts above have these letters. Signs of
// Chinese, Japanese and Korean are in none of them, and would take tens of megabytes.
constexpr std::array<ImWchar, 17> kLetters = {
    0x0020, 0x024F, // Latin
    0x0370, 0x03FF, // Greek
    0x0400, 0x052F, // Cyrillic
    0x0531, 0x058F, // Armenian
    0x1E00, 0x1EFF, // Latin, as in Vietnamese
    0x2010, 0x2044, // dashes, quotation marks
    0x20A0, 0x20BF, // currencies
    0x2100, 0x214F, // letters as signs
    0,
};

void loadFont(float scale) {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    std::error_code code;
    for (const char* path : kFonts) {
        if (!std::filesystem::exists(path, code)) continue;
        const auto add = [&](float share) {
            return io.Fonts->AddFontFromFileTTF(path, std::round(share * kFontPixels * scale), nullptr,
                                                kLetters.data()) != nullptr;
        };
        if (add(1.0f) && add(kTitle)) return;
        io.Fonts->Clear();
    }
    for (const float share : {1.0f, kTitle}) {
        ImFontConfig config;
        config.SizePixels = std::round(share * kBuiltInPixels * scale);
        io.Fonts->AddFontDefault(&config);
    }
}

void setColours(ImGuiStyle& style) {
    ImGui::StyleColorsDark(&style);
    const ImVec4 accent(0.85f, 0.55f, 0.20f, 1.0f), quiet(0.20f, 0.21f, 0.23f, 1.0f);
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.10f, 0.105f, 0.115f, 1.0f);
    style.Colors[ImGuiCol_PopupBg] = ImVec4(0.10f, 0.105f, 0.115f, 0.98f);
    style.Colors[ImGuiCol_MenuBarBg] = ImVec4(0.13f, 0.135f, 0.15f, 1.0f);
    style.Colors[ImGuiCol_FrameBg] = quiet;
    style.Colors[ImGuiCol_Button] = ImVec4(0.26f, 0.27f, 0.30f, 1.0f);
    style.Colors[ImGuiCol_Header] = ImVec4(0.24f, 0.25f, 0.28f, 1.0f);
    style.Colors[ImGuiCol_Tab] = quiet;
    style.Colors[ImGuiCol_TitleBgActive] = style.Colors[ImGuiCol_Header];
    style.Colors[ImGuiCol_ResizeGrip] = quiet;
    for (const int colour :
         {ImGuiCol_FrameBgHovered, ImGuiCol_ButtonHovered, ImGuiCol_HeaderHovered, ImGuiCol_TabHovered})
        style.Colors[colour] = ImVec4(0.45f, 0.33f, 0.20f, 1.0f);
    for (const int colour :
         {ImGuiCol_FrameBgActive, ImGuiCol_ButtonActive, ImGuiCol_HeaderActive, ImGuiCol_TabActive})
        style.Colors[colour] = ImVec4(0.60f, 0.40f, 0.18f, 1.0f);
    for (const int colour : {ImGuiCol_CheckMark, ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive,
                             ImGuiCol_PlotLines, ImGuiCol_PlotHistogram})
        style.Colors[colour] = accent;
}

} // namespace

Gui::Gui(Window& window) : window_(window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;              // preferences.h keeps what is to be kept
    ImGui::GetIO().ConfigInputTextCursorBlink = false; // nothing is to be drawn for a blinking cursor alone
    ImGui_ImplGlfw_InitForOpenGL(window.handle(), false); // feed() calls what it would install
    ImGui_ImplOpenGL3_Init("#version 450 core");
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Gui::setScale(float scale) {
    if (scale == scale_) return;
    [[maybe_unused]] const bool again = scale_ > 0;
    scale_ = scale;
    ImGuiStyle style;
    setColours(style);
    style.WindowRounding = 0;
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.WindowBorderSize = 0;
    style.ScaleAllSizes(scale);
    ImGui::GetStyle() = style;
    loadFont(scale);
#if IMGUI_VERSION_NUM < 19200 // later ones do so themselves
    if (again) ImGui_ImplOpenGL3_DestroyFontsTexture();
    if (again) ImGui_ImplOpenGL3_CreateFontsTexture();
#endif
}

void Gui::feed(const WindowEvent& event) {
    GLFWwindow* window = window_.handle();
    const int state = event.repeated ? GLFW_REPEAT : event.pressed ? GLFW_PRESS : GLFW_RELEASE;
    switch (event.kind) {
    case WindowEvent::Kind::Key:
        feedSeen();
        // A key that goes down and up between two frames would never be seen down.
        if (!event.pressed && std::find(pressed_.begin(), pressed_.end(), event.place) != pressed_.end()) {
            releases_.push_back(event);
            break;
        }
        if (event.pressed) pressed_.push_back(event.place);
        feedKey(event, state);
        break;
    case WindowEvent::Kind::Letter:
        ImGui_ImplGlfw_CharCallback(window, static_cast<unsigned>(event.code));
        break;
    case WindowEvent::Kind::Button:
        ImGui_ImplGlfw_MouseButtonCallback(window, event.code, state, event.mods);
        break;
    case WindowEvent::Kind::Scroll:
        ImGui_ImplGlfw_ScrollCallback(window, event.at.x, event.at.y);
        break;
    case WindowEvent::Kind::Focus:
        ImGui_ImplGlfw_WindowFocusCallback(window, event.pressed ? GLFW_TRUE : GLFW_FALSE);
        break;
    case WindowEvent::Kind::Enter:
        ImGui_ImplGlfw_CursorEnterCallback(window, event.pressed ? GLFW_TRUE : GLFW_FALSE);
        break;
#if IMGUI_VERSION_NUM >= 18700 // earlier ones ask for the cursor's place themselves
    case WindowEvent::Kind::Cursor:
        ImGui_ImplGlfw_CursorPosCallback(window, event.at.x, event.at.y);
        break;
#endif
    default:
        break;
    }
}

// Feeds a key. Where keys go through controls, Enter presses them as Space does: ImGui would only begin to
// edit the few that have a text.
void Gui::feedKey(const WindowEvent& event, int state) {
    GLFWwindow* window = window_.handle();
    const bool enter = event.place == GLFW_KEY_ENTER || event.place == GLFW_KEY_KP_ENTER;
    const bool presses = enter && navigates_ && !wantsKeyboard();
    const bool released = state == GLFW_RELEASE; // whatever it was when it went down
    if (event.place == GLFW_KEY_TAB && navigates_ && !wantsKeyboard() && !released) {
        tabs_ += (event.mods & GLFW_MOD_SHIFT) != 0 ? -1 : 1;
        return;
    }
    if (enter && (presses || released))
        ImGui_ImplGlfw_KeyCallback(window, GLFW_KEY_SPACE, 0, state, event.mods);
    if (!presses || released)
        ImGui_ImplGlfw_KeyCallback(window, event.place, event.scancode, state, event.mods);
}

void Gui::navigate(bool on) {
    navigates_ = on;
    if (!on) tabs_ = 0;
    ImGuiConfigFlags& flags = ImGui::GetIO().ConfigFlags;
    flags = on ? flags | ImGuiConfigFlags_NavEnableKeyboard : flags & ~ImGuiConfigFlags_NavEnableKeyboard;
}

// Feeds the releases that had to wait. It is never called within a frame: the modifiers that widgets see must
// not change meanwhile.
void Gui::feedSeen() {
    for (const WindowEvent& event : std::exchange(seen_, {}))
        feedKey(event, GLFW_RELEASE);
}

void Gui::begin(float scale) {
    setScale(scale);
    feedSeen();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    pressed_.clear();
    seen_ = std::exchange(releases_, {});
}

void Gui::end() {
    ImGui::Render();
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE); // the scene sets another one
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool Gui::wantsMouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

bool Gui::wantsKeyboard() const {
    return ImGui::GetIO().WantTextInput;
}

ImFont* Gui::titleFont() {
    return ImGui::GetIO().Fonts->Fonts.back();
}

bool Gui::hasInputLeft() const {
#if IMGUI_VERSION_NUM >= 18700
    return !ImGui::GetCurrentContext()->InputEventsQueue.empty();
#else
    return false;
#endif
}

bool Gui::animates() const {
    return ImGui::IsAnyItemActive() && !ImGui::GetIO().WantTextInput;
}

} // namespace relume
