"""Local spectra: their second moments, by a bank of Gabor filters or by the structure tensor."""
