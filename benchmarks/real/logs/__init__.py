"""Motion logs of real arms."""
