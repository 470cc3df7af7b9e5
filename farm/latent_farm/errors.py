"""What ends latent-farm: one line, and an exit status of README.md's table."""

import re

DONE, FAILED, USAGE, STOPPED = 0, 1, 2, 75


class Failure(Exception):
    """The world's faults: what happened, where, and what to do."""

    status = FAILED


class Misuse(Failure):
    """Wrong arguments."""

    status = USAGE


URL = re.compile(r"(?i)(https?:/*)(?:[^\s/?#]*@)?([^\s?#]*)([?#]\S*)?")  # with one slash, where it was taken for a path


def without_secrets(text):
    """URLs without user and password, and with ?... for their query, which may be a key."""
    return URL.sub(lambda url: url[1] + url[2] + ("?..." if (url[3] or "").startswith("?") else ""), text)


def check_is_no_url(name, what):
    if URL.match(name):
        raise Misuse(f"{what}, not a URL: {name}")
