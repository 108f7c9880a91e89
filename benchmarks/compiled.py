"""What peers on the compiled right-hand side have in common."""

import copy


class Compiled:
    """A method on `model.rates`."""

    slider_time = 1e-6
    """tau_s [s]"""

    def with_slider_time(self, slider_time: float):
        """The same with another relaxation time of the slider [s]."""
        other = copy.copy(self)
        other.slider_time = slider_time
        return other
