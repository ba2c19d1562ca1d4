"""Attributes of arrays in a netCDF-4 file: plain values, and those by which netCDF keeps axes.

The netCDF library takes its own attributes to be what it would have written; others of the same
name crash it, or worse. They are held against what it writes, before it sees them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import h5py

_LARGEST_NUMBER = 1000  # of attributes of an array, and of the values of each
_LARGEST_TEXTS = 32
#: How names of attributes begin that mean something to netCDF or HDF5 itself.
_RESERVED = ("_NC", "_Nc", "_nc", "_Netcdf", "CLASS", "NAME", "DIMENSION_", "REFERENCE_")


def attributes_objection(item: Any, name: str, entries: set[str]) -> str:
    """Why the attributes of an array, or of the file, are refused; "" if they are not.

    Parameters
    ----------
    item : low-level h5py object.
    name : of it, for the message.
    entries : names of the arrays in the file.
    """
    import h5py

    number = h5py.h5a.get_num_attrs(item)
    if number > _LARGEST_NUMBER:
        return f"{name} has more than {_LARGEST_NUMBER} attributes"
    array = h5py.Dataset(item) if isinstance(item, h5py.h5d.DatasetID) else None
    for index in range(number):
        attribute = h5py.h5a.open(item, index=index)
        told = ascii(attribute.name.decode(errors="replace"))[:60]
        if reason := _objection(attribute, array, entries):
            return f"the attribute {told} of {name} {reason}"
    return ""


def _objection(attribute: Any, array: h5py.Dataset | None, entries: set[str]) -> str:
    import h5py

    name, kind = attribute.name.decode(errors="replace"), attribute.get_type()
    group, length = kind.get_class(), int(np.prod(attribute.shape, dtype=object))
    odd = "is not what netCDF writes"
    if name in _OWN or name.startswith(_RESERVED):
        check = _OWN.get(name)
        return "" if check is not None and check(attribute, array, entries) else odd
    if group not in (h5py.h5t.INTEGER, h5py.h5t.FLOAT, h5py.h5t.STRING):
        return "is neither a number nor text"
    varies = group == h5py.h5t.STRING and kind.is_variable_str()
    if len(attribute.shape) > 1 or length > (_LARGEST_TEXTS if varies else _LARGEST_NUMBER):
        return f"has {length} values"
    return ""


def _is_fixed_text(attribute: Any, array: Any, entries: set[str]) -> bool:
    import h5py

    kind = attribute.get_type()
    is_text = kind.get_class() == h5py.h5t.STRING and not kind.is_variable_str()
    return is_text and attribute.shape == () and kind.get_size() < 1000


def _is_fill_value(attribute: Any, array: Any, entries: set[str]) -> bool:
    if array is None:
        return False
    kind, own = attribute.get_type(), array.id.get_type()
    same = (kind.get_class(), kind.get_size()) == (own.get_class(), own.get_size())
    return same and attribute.shape in ((), (1,))


def _are_axis_numbers(attribute: Any, array: Any, entries: set[str]) -> bool:
    """Axes of an array, or the number of one, as netCDF counts them."""
    import h5py

    shape = () if attribute.name == b"_Netcdf4Dimid" else None if array is None else (array.ndim,)
    kind = attribute.get_type()
    if kind.get_class() != h5py.h5t.INTEGER or kind.get_size() != 4 or attribute.shape != shape:
        return False
    values = np.zeros(attribute.shape, dtype=np.int32)
    attribute.read(values)
    return bool((values >= 0).all() and (values < len(entries)).all())


def _is_dimension_list(attribute: Any, array: Any, entries: set[str]) -> bool:
    """For each axis of an array one reference to another array of the file."""
    import h5py

    kind = attribute.get_type()
    if array is None or attribute.shape != (array.ndim,) or not array.ndim:
        return False
    if kind.get_class() != h5py.h5t.VLEN or not _is_reference(kind.get_super()):
        return False
    axes = array.attrs["DIMENSION_LIST"]
    return all(len(axis) == 1 and _names_entry(array.file, axis[0], entries) for axis in axes)


def _is_reference_list(attribute: Any, array: Any, entries: set[str]) -> bool:
    """The arrays that have this one as an axis, and which axis it is."""
    import h5py

    kind = attribute.get_type()
    if array is None or kind.get_class() != h5py.h5t.COMPOUND or kind.get_nmembers() != 2:
        return False
    if not _is_reference(kind.get_member_type(0)) or len(attribute.shape) != 1:
        return False
    if kind.get_member_class(1) != h5py.h5t.INTEGER or attribute.shape[0] > _LARGEST_NUMBER:
        return False
    return all(_names_entry(array.file, row[0], entries) for row in array.attrs["REFERENCE_LIST"])


def _is_reference(kind: Any) -> bool:
    import h5py

    return bool(kind.get_class() == h5py.h5t.REFERENCE and kind.equal(h5py.h5t.STD_REF_OBJ))


def _names_entry(file: h5py.File, reference: Any, entries: set[str]) -> bool:
    try:
        return bool(reference) and str(file[reference].name).removeprefix("/") in entries
    except (KeyError, ValueError, OSError, RuntimeError):  # it leads nowhere
        return False


_OWN = {
    "CLASS": _is_fixed_text,
    "NAME": _is_fixed_text,
    "_NCProperties": _is_fixed_text,
    "_FillValue": _is_fill_value,
    "_Netcdf4Coordinates": _are_axis_numbers,
    "_Netcdf4Dimid": _are_axis_numbers,
    "DIMENSION_LIST": _is_dimension_list,
    "REFERENCE_LIST": _is_reference_list,
}
