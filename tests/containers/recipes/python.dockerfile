FROM {base}
RUN apt-get update -q && apt-get install -q -y --no-install-recommends python3 python3-venv make ca-certificates \
    && ln -s /usr/bin/python3 /usr/local/bin/python3 && ln -s /usr/bin/python3 /usr/local/bin/python \
    && rm -rf /var/lib/apt/lists/* && echo "$(. /etc/os-release; echo $PRETTY_NAME), $(python3 --version)" > /stand-in
CMD ["python3"]
