"""How large an input may be: held against a file's header before anything is decoded or allocated."""

from __future__ import annotations

from dataclasses import dataclass

from visint.errors import InputError

__all__ = ["LIMITS", "Limits"]

_MEGA = 1 << 20


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest input that is read.

    Parameters
    ----------
    megapixels
        Of one image, 2²⁰ pixels each. A larger one lets larger pictures in, at about 4 bytes of memory a
        pixel and channel beyond the decoded samples.
    megabytes
        Of one file, of the samples decoded from it, and of one stored array, 2²⁰ bytes each.
    """

    megapixels: int = 64
    megabytes: int = 512

    @property
    def most_bytes(self) -> int:
        """The largest file and the largest decoded array, bytes."""
        return self.megabytes * _MEGA

    def check_size(self, name: str, size: int) -> None:
        """Refuse ``size`` bytes of decoded data.

        Raises
        ------
        InputError
            VI303, if they are more than ``megabytes``.
        """
        if size > self.most_bytes:
            found = f"holds {size / _MEGA:.4g} MB of data; at most {self.megabytes} MB are read"
            raise InputError.of("VI303", found, where=name)

    def check_image(self, name: str, width: int, height: int, sample_bytes: int) -> None:
        """Refuse an image by what its header claims; ``sample_bytes`` is channels × bytes a sample.

        Raises
        ------
        InputError
            VI302 if a side is zero, VI303 if the image is too large.
        """
        if width < 1 or height < 1:
            raise InputError.of("VI302", f"claims {width} × {height} pixels; wants at least 1 × 1", where=name)
        if width * height > self.megapixels * _MEGA:
            found = (
                f"claims {width} × {height} pixels ({width * height / _MEGA:.4g} MP); "
                f"at most {self.megapixels} MP are read"
            )
            raise InputError.of("VI303", found, where=name)
        self.check_size(name, width * height * sample_bytes)


LIMITS = Limits()
"""64 MP and 512 MB."""
