// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/row_class.h"

namespace slamdb::python {

namespace py = pybind11;

std::vector<std::size_t> RowsOfMask(const py::object& index, std::size_t size) {
  const py::array given = ArrayOrNull(index);
  if (!given || given.dtype().kind() != 'b' || given.ndim() != 1)
    throw py::type_error(
        "rows are taken by a number, a slice or a mask (N,) bool; by_id and rows_of look ids up, and columns "
        "(ids, positions, ...) take all that numpy does");
  if (static_cast<std::size_t>(given.size()) != size)
    throw py::index_error("the mask is of " + std::to_string(given.size()) + " rows; there are " +
                          std::to_string(size));
  const py::array_t<bool, py::array::c_style> mask(given);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < size; ++row)
    if (mask.data()[row]) rows.push_back(row);
  return rows;
}

}  // namespace slamdb::python
