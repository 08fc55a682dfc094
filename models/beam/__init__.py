"""The cantilever by assumed modes: shapes, Ritz matrices and the reduced modal model."""
