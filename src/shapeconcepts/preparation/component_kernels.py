"""Kernel that finds connected components: SciPy's take 3.5 ms, as long as all the rest of a segmentation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shapeconcepts.kernels import kernel


@kernel
def connected_components(indptr: NDArray[np.int64], indices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Number the connected components of a symmetric graph in CSR form in the order of their first vertex."""
    m = len(indptr) - 1
    component = np.full(m, -1, np.int32)
    stack = np.empty(m, np.int32)
    count = 0
    reached = 0
    for start in range(m):
        if component[start] >= 0:
            continue
        component[start] = count
        reached += 1
        stack[0] = start
        depth = 1
        while depth > 0 and reached < m:
            depth -= 1
            i = stack[depth]
            for k in range(np.uint64(indptr[i]), np.uint64(indptr[i + 1])):
                j = np.uint32(indices[k])  # an unsigned index needs no test for counting from the end
                if component[j] < 0:
                    component[j] = count
                    reached += 1
                    stack[depth] = j
                    depth += 1
        count += 1
    return component
