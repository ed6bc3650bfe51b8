#include "app/live/edit_history.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <random>
#include <string>

namespace relume {
namespace {

/// A document that is told apart by one number.
Document document(uint32_t number) {
    Document made;
    made.bake.size = number;
    return made;
}

uint32_t numberOf(const std::optional<Document>& found) {
    return found ? found->bake.size : 0;
}

} // namespace

TEST(EditHistory, NothingIsLeftAtBothEnds) {
    EditHistory history;
    EXPECT_FALSE(history.undo());
    EXPECT_FALSE(history.redo());
    EXPECT_FALSE(history.cancel());
    EXPECT_EQ(history.undoName() + history.redoName(), "");
    history.add("first", document(1), document(2));
    EXPECT_FALSE(history.redo());
    EXPECT_EQ(numberOf(history.undo()), 1u);
    EXPECT_FALSE(history.undo());
    EXPECT_EQ(history.redoName(), "first");
    EXPECT_EQ(numberOf(history.redo()), 2u);
}

TEST(EditHistory, EditsOfOneNameAreOneStepUntilTheyEnd) {
    EditHistory history;
    history.add("drag", document(1), document(2));
    history.add("drag", document(2), document(3));
    history.end();
    history.add("drag", document(3), document(4));
    history.add("other", document(4), document(5));
    EXPECT_EQ(numberOf(history.undo()), 4u);
    EXPECT_EQ(numberOf(history.undo()), 3u);
    EXPECT_EQ(numberOf(history.undo()), 1u);
    EXPECT_EQ(numberOf(history.redo()), 3u);
}

TEST(EditHistory, AnOpenStepIsCancelledAndAnEndedOneIsNot) {
    EditHistory history;
    history.add("drag", document(1), document(2));
    history.add("drag", document(2), document(3));
    EXPECT_EQ(numberOf(history.cancel()), 1u);
    EXPECT_FALSE(history.cancel());
    EXPECT_FALSE(history.undo());
    history.add("drag", document(1), document(2));
    history.end();
    EXPECT_FALSE(history.cancel());
    EXPECT_EQ(numberOf(history.undo()), 1u);
    EXPECT_FALSE(history.cancel()) << "what is undone is no open step";
}

TEST(EditHistory, ANewStepForgetsWhatWasUndoneAndTheOldestBeyondTheMost) {
    EditHistory history;
    const auto most = static_cast<uint32_t>(EditHistory::kMostSteps);
    for (uint32_t i = 1; i <= most + 10; ++i)
        history.add("step " + std::to_string(i), document(i), document(i + 1));
    uint32_t steps = 0, oldest = 0;
    while (const std::optional<Document> before = history.undo()) {
        oldest = numberOf(before);
        ++steps;
    }
    EXPECT_EQ(steps, most);
    EXPECT_EQ(oldest, 11u);
    history.redo();
    history.add("another", document(12), document(99));
    EXPECT_FALSE(history.redo());
    EXPECT_EQ(history.undoName(), "another");
}

// A walk of a thousand random actions beside a list that is kept the plain way.
TEST(EditHistory, AgreesWithAPlainListOverRandomActions) {
    std::mt19937 random(5);
    EditHistory history;
    std::deque<uint32_t> states = {1};
    size_t at = 0;
    uint32_t next = 2;
    for (int action = 0; action < 1000; ++action) {
        switch (random() % 3) {
        case 0:
            history.add("edit " + std::to_string(next), document(states[at]), document(next));
            states.resize(++at);
            states.push_back(next++);
            if (at > EditHistory::kMostSteps) {
                states.pop_front();
                --at;
            }
            break;
        case 1: {
            const std::optional<Document> before = history.undo();
            ASSERT_EQ(before.has_value(), at > 0);
            if (before) {
                ASSERT_EQ(numberOf(before), states[--at]);
            }
            break;
        }
        default: {
            const std::optional<Document> after = history.redo();
            ASSERT_EQ(after.has_value(), at + 1 < states.size());
            if (after) {
                ASSERT_EQ(numberOf(after), states[++at]);
            }
        }
        }
    }
}

} // namespace relume
