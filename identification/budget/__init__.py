from identification.budget.budget import Budget, budget_of

__all__ = ["Budget", "budget_of"]
