"""What ends latent-farm: one line, and an exit status of README.md's table."""

DONE, FAILED, USAGE, LOSSES, STOPPED = 0, 1, 2, 3, 75


class Failure(Exception):
    """The world's faults: what happened, where, and what to do."""

    def __init__(self, text, status=FAILED):
        super().__init__(text)
        self.status = status


class Misuse(Failure):
    """Wrong arguments."""

    def __init__(self, text):
        super().__init__(text, USAGE)
