#pragma once

#include <functional>
#include <string>
#include <vector>

namespace relume {

/// Asks one question, before anything else goes on. Each answer has a key.
class Question {
public:
    struct Answer {
        std::string label;
        int key = 0; // GLFW_KEY_
        std::function<void()> done = {};
    };
    /// Asks. The last answer does nothing: it is what Esc means.
    void ask(const std::string& text, std::vector<Answer> answers);
    bool isOpen() const { return !answers_.empty(); }
    void close() { answers_.clear(); }
    /// Gives the answer of a key. Returns false where it has none.
    bool answer(int key);
    void draw();

private:
    void give(size_t index);

    std::string text_;
    std::vector<Answer> answers_;
};

} // namespace relume
