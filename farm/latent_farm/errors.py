"""What ends latent-farm: one line, and an exit status of README.md's table."""

DONE, FAILED, USAGE, STOPPED = 0, 1, 2, 75


class Failure(Exception):
    """The world's faults: what happened, where, and what to do."""

    status = FAILED


class Misuse(Failure):
    """Wrong arguments."""

    status = USAGE
