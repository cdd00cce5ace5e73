"""The effects study: which effects a scene needs, what each costs, what an engine adds unasked."""
