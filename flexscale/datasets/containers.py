"""Is a data.nc complete in itself, and no larger than it seems?

HDF5, in which netCDF-4 files are kept, has ways out of a file: values stored in other files,
virtual datasets made of others, links into other files, and filters loaded as libraries. It also
has ways to be endless: links in circles, and arrays of any size that take no space. netCDF follows
them all. A dataset of ours is one flat group of arrays within its file; anything else is refused
here, before the netCDF library sees it.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.container_attributes import attributes_objection
from flexscale.errors import IntegrityError

if TYPE_CHECKING:
    import h5py

#: What HDF5, netCDF and xarray raise on damaged files; they promise nothing.
FOREIGN = (OSError, RuntimeError, ValueError, TypeError, LookupError, ArithmeticError, MemoryError)

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
#: Arrays may hold this many bytes, or so many times the size of their file if that is more.
_FREE_BYTES = 64 * 2**20
_LARGEST_RATIO = 200
_LARGEST_NUMBER = 1000  # of arrays in a file, of texts in one array
#: Deflate, shuffle, Fletcher-32: compiled into every HDF5. All others are loaded from somewhere.
_FILTERS = (1, 2, 3)


def require_self_contained(content: bytes, where: object) -> None:
    """Refuse a file that reaches outside of itself or declares more than it can hold.

    Parameters
    ----------
    content : bytes of the file.
    where : its path, for the message.

    Raises
    ------
    IntegrityError : with the reason.
    """
    import h5py

    if not content.startswith(_SIGNATURE):
        raise IntegrityError(f"{where} is no netCDF-4 file.")
    try:
        # As a file object HDF5 has no other file to open, whatever the content asks for.
        with h5py.File(io.BytesIO(content), "r") as file:
            reason = _objection(file, len(content))
    except FOREIGN as error:
        raise IntegrityError(f"{where} is not readable as netCDF: {error!r:.200}.") from error
    if reason:
        raise IntegrityError(f"{where} is not opened: {reason}.")


def _objection(file: h5py.File, size: int) -> str:
    """Why the file is refused, "" if it is not."""
    import h5py

    root, total = file.id, 0
    if root.get_num_objs() > _LARGEST_NUMBER:
        return f"it holds more than {_LARGEST_NUMBER} arrays"
    entries: list[bytes] = []
    root.links.iterate(entries.append)
    arrays: dict[str, h5py.h5d.DatasetID] = {}
    for raw in entries:
        name = ascii(raw.decode(errors="replace"))[:60]
        if root.links.get_info(raw).type != h5py.h5l.TYPE_HARD:
            return f"its entry {name} is a link to somewhere else"
        if h5py.h5o.get_info(root, raw).type != h5py.h5o.TYPE_DATASET:
            return f"its entry {name} is a group or a type, and datasets hold arrays only"
        array = arrays[name] = h5py.h5d.open(root, raw)
        if reason := _storage_objection(array):
            return f"its array {name} {reason}"
        total += _bytes_of(array, size)
        if total > max(_FREE_BYTES, _LARGEST_RATIO * size):
            return (
                f"its arrays up to {name} declare {float(total):.2g} bytes, which a file of "
                f"{size} bytes does not hold"
            )
    names = {raw.decode(errors="replace") for raw in entries}
    for name, item in {"the file": root, **arrays}.items():
        if reason := attributes_objection(item, name, names):
            return reason
    return ""


def _storage_objection(array: Any) -> str:
    """Whether values lie elsewhere, or need foreign code to be read."""
    import h5py

    made = array.get_create_plist()
    if made.get_external_count() > 0:
        return "keeps its values in another file"
    if made.get_layout() not in (h5py.h5d.COMPACT, h5py.h5d.CONTIGUOUS, h5py.h5d.CHUNKED):
        return "is put together from other arrays (a virtual dataset)"
    for number in range(made.get_nfilters()):
        if made.get_filter(number)[0] not in _FILTERS:
            return f"needs the filter {made.get_filter(number)[0]}, which is not part of netCDF"
    if _type_objection(array.get_type()):
        return "holds neither numbers nor text"
    return ""


def _type_objection(kind: Any) -> bool:
    import h5py

    plain = (h5py.h5t.INTEGER, h5py.h5t.FLOAT, h5py.h5t.STRING)
    return kind.get_class() not in plain


def _bytes_of(array: Any, size: int) -> int:
    """Bytes that reading an array takes; of text, that each element can be as long as the file."""
    import h5py

    number = int(np.prod([int(n) for n in array.shape], dtype=object))
    kind = array.get_type()
    if kind.get_class() == h5py.h5t.STRING and kind.is_variable_str():
        if number > _LARGEST_NUMBER:
            return 2**62
        # Elements may share their bytes in the file, so only reading tells their length.
        texts = h5py.Dataset(array)
        return sum(len(texts[index]) for index in np.ndindex(array.shape))
    made = array.get_create_plist()
    chunk = made.get_chunk() if made.get_layout() == h5py.h5d.CHUNKED else ()
    return max(number, int(np.prod([int(n) for n in chunk], dtype=object))) * int(kind.get_size())
