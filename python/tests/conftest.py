"""What all tests begin with."""

import signal

# A shell starts commands in its background with SIGINT ignored, and Python then leaves it so.
signal.signal(signal.SIGINT, signal.default_int_handler)
