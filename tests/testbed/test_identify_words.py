"""What an identification says in words."""

import numpy as np

from identification.decay.cause import Cause
from identification.decay.course import Course, Jump
from testbed.identify.words import cause_in_words


def test_a_jump_has_its_time_with_one_deviation_that_is_called_so():
    flat = np.zeros(2)
    course = Course(np.array([0.0, 1.0]), flat, flat, flat, {}, (Jump(0.5, 0.012, 0.99, 1.0),))
    cause = Cause("irregular", {"steady": 0.0, "irregular": 1.0, "amplitude": 0.0, "time": 0.0}, None)
    told = cause_in_words("damping", cause, course, several=False)
    assert told.endswith("it jumps at 0.5 +- 0.012 s (1 std)")
