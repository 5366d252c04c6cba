"""The explorer: a model's page, alive, on this computer alone.

`server` opens the socket and answers at once; all that takes long, numba and scikit-learn among it, is
imported by the `session`, which reads the model meanwhile.
"""
