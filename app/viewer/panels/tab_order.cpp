#include "app/viewer/panels/tab_order.h"

#include <imgui.h>
#include <imgui_internal.h>

namespace relume::ui {
namespace {

TabOrder* innermostOrder = nullptr;

// Shows which control has the keyboard's focus. Dear ImGui 1.87 on no longer does so by itself, and presses
// none that is not shown to have it.
void showFocus() {
#if IMGUI_VERSION_NUM >= 19140
    ImGui::SetNavCursorVisible(true);
#else
    ImGui::GetCurrentContext()->NavDisableHighlight = false;
#endif
}

} // namespace

int tabStop(int focused, int steps, int count) {
    if (count <= 0) return -1;
    const int from = focused >= 0 ? focused : (steps > 0 ? -1 : count);
    const int stop = (from + steps) % count;
    return stop < 0 ? stop + count : stop;
}

TabOrder::Scope::Scope(TabOrder& order) : outer_(innermostOrder) {
    innermostOrder = &order;
}

TabOrder::Scope::~Scope() {
    innermostOrder = outer_;
}

TabOrder* TabOrder::current() {
    return innermostOrder;
}

void TabOrder::begin(int steps) {
    count_ = drawn_;
    wanted_ = steps != 0 ? tabStop(focused_ < count_ ? focused_ : -1, steps, count_) : -1;
    drawn_ = 0;
    focused_ = -1;
}

void TabOrder::add() {
    // A focus that is not shown yet is the first thing that Tab shows.
    if (ImGui::IsItemFocused() && ImGui::GetIO().NavVisible) focused_ = drawn_;
    if (drawn_ == wanted_) {
        ImGui::SetKeyboardFocusHere(-1); // on the control before, which is the last one
        showFocus();
        focused_ = drawn_;
    }
    ++drawn_;
}

} // namespace relume::ui
