"""An answer is kept for the same objects, and for the last ones alone."""

import pytest

from identification.last_answer import LastAnswer


def test_an_answer_is_found_once_for_the_same_objects():
    last, asked = LastAnswer[str](), []
    one, other = [1], [1]  # equal, not the same

    def answer_about(*objects):
        return last.about(*objects, ask=lambda: asked.append(objects) or f"answer {len(asked)}")

    assert [answer_about(one, other) for _ in range(2)] == ["answer 1", "answer 1"]
    assert answer_about(one, one) == "answer 2"
    assert answer_about(one, other) == "answer 3"
    last.keep(one, one, answer="from elsewhere")
    assert answer_about(one, one) == "from elsewhere"


def test_a_question_that_fails_leaves_what_was_known():
    last = LastAnswer[str]()
    last.keep("this", answer="known")
    with pytest.raises(ZeroDivisionError):
        last.about("that", ask=lambda: 1 / 0)
    assert last.about("this", ask=lambda: "asked again") == "known"
