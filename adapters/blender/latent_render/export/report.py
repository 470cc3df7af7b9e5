"""What Latent cannot say of a scene, for the panel and the report."""


class Report:
    def __init__(self):
        self.lines = {}

    def lost(self, owner, what):
        """`owner`: such as "material Wood". Each line appears once."""
        self.lines.setdefault(f"{owner}: {what}", None)

    def of(self, owner):
        """A function that takes what is lost of one owner."""
        return lambda what: self.lost(owner, what)


class Unknown(Exception):
    """A node that Latent cannot say."""
