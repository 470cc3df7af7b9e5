"""Numbers as people read and write them; the same grammar as the other tools'."""
import argparse
import re

MOST_SECONDS = 1e9  # that an option can ask for


def parse_duration(text):
    """Seconds of 90, 10m or 1h30m."""
    match = re.fullmatch(r"(?:(\d+(?:\.\d+)?)h)?(?:(\d+(?:\.\d+)?)m)?(?:(\d+(?:\.\d+)?)s?)?", text)
    if not text or not match:
        raise argparse.ArgumentTypeError(f"'{text}' is not a time (try 90, 10m or 1h30m)")
    hours, minutes, seconds = (float(part or 0) for part in match.groups())
    total = 3600 * hours + 60 * minutes + seconds
    if not total <= MOST_SECONDS:
        raise argparse.ArgumentTypeError(f"'{text}' is longer than 30 years")
    return total


def parse_number(text, kilo=1000):
    """The value of 64, 1.5K or 64Ki, where K, M, G and T are powers of `kilo`, Ki to Ti of 1024; None if it is no number."""
    match = re.fullmatch(r"(\d+(?:\.\d*)?(?:e[+-]?\d{1,3})?|\.\d+)(?:([KMGT])(i?))?", text, re.ASCII | re.IGNORECASE)
    if not match:
        return None
    value = float(match[1]) if re.search(r"[.e]", match[1], re.IGNORECASE) else int(match[1])
    return value * (1024 if match[3] else kilo) ** " KMGT".index((match[2] or " ").upper())


def parse_size(text):
    """Bytes of 512M or 1.5G, where K, M, G and T are powers of 1024."""
    value = parse_number(text, 1024)
    if value is None or not 1 <= value <= 2**62:
        raise argparse.ArgumentTypeError(f"'{text}' is not a size (try 512M or 1.5G)")
    return int(value)


def counted(count, noun):
    """As "1 task", "2 tasks"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def left_out(report):
    """What is to be said of the steps that --until leaves out."""
    return f", except what --until {report['until']} leaves out: {', '.join(report['steps_left_out'])}" if report["steps_left_out"] else ""


def format_duration(seconds):
    """As "12s", "42m", "3h05m" or "7 days"."""
    if seconds < 100:
        return f"{seconds:.0f}s"
    if seconds > 100 * 3600:
        return f"{seconds / 86400:.0f} days" if seconds < 36525 * 86400 else "over 100 years"
    minutes = round(seconds / 60)
    return f"{minutes}m" if minutes < 60 else f"{minutes // 60}h{minutes % 60:02}m"


def format_size(count):
    """As "1.5 GiB"."""
    for unit in ("bytes", "KiB", "MiB", "GiB", "TiB"):
        if count < 1024 or unit == "TiB":
            return f"{count:.0f} {unit}" if unit == "bytes" else f"{count:.1f} {unit}"
        count /= 1024


def format_count(count):
    """As "999", "1.2 M"."""
    for unit, size in (("T", 1e12), ("G", 1e9), ("M", 1e6), ("K", 1e4)):
        if count >= size:
            return f"{count / (1e3 if unit == 'K' else size):.1f} {unit}"
    return f"{count:.0f}"
