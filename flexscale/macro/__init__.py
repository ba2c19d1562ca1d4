"""From a sweep to the macro model: two-regime laws, circular harmonics, errors of the fit."""
