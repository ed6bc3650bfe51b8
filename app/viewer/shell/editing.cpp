#include "app/viewer/shell/editing.h"

namespace relume {

Editing::Editing(Session& session, Comparison& comparison, LightProgress& progress, Feedback& feedback)
    : session_(session), comparison_(comparison), progress_(progress), feedback_(feedback) {}

void Editing::prepare(const std::string& name, bool goesOn) {
    comparison_.beforeEdit(progress_.converged());
    progress_.edited(name, goesOn, feedback_.now());
}

void Editing::edit(const std::string& name, const Document& next) {
    if (name != edited_) feedback_.tell("edit", name);
    prepare(name, name == edited_);
    edited_ = name;
    session_.edit(name, next);
    feedback_.pacer().input();
}

void Editing::end() {
    edited_.clear();
    session_.endEdit();
}

void Editing::editOnce(const std::string& name, const Document& next) {
    edit(name, next);
    end();
}

void Editing::undo() {
    const std::string name = session_.undoName();
    edited_.clear();
    if (!name.empty()) prepare("undo of " + name, false);
    if (!session_.undo()) return feedback_.note("nothing to undo");
    feedback_.tell("undo", name);
}

void Editing::redo() {
    const std::string name = session_.redoName();
    edited_.clear();
    if (!name.empty()) prepare("redo of " + name, false);
    if (!session_.redo()) return feedback_.note("nothing to make again");
    feedback_.tell("redo", name);
}

} // namespace relume
