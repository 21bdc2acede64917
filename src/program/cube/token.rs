//! Termination by a token (Dijkstra's EWD998, after Safra): a node's counter of rays and results sent and not taken, a colour, and a token
//! that goes round from node 0 on and sums the counters up.

/// What a token says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Token {
    /// The counters of the nodes that it has come by.
    pub count: i64,
    /// Whether one of them had taken a message since it was there before.
    pub is_black: bool,
}

/// What a node knows of the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Account {
    /// Rays and results that it has sent, less those that it has taken.
    pub count: i64,
    /// Whether it has taken any since the token was here.
    pub is_black: bool,
    /// The token, if it is here.
    pub token: Option<Token>,
}

impl Account {
    /// A ray or a result is sent.
    pub fn sent(&mut self) {
        self.count += 1;
    }

    /// One is taken.
    pub fn taken(&mut self) {
        self.count -= 1;
        self.is_black = true;
    }

    /// The token goes on, if it is here; the node turns white.
    pub fn pass(&mut self) -> Option<Token> {
        let token = self.token.take()?;
        let passed = Token { count: token.count + self.count, is_black: token.is_black || self.is_black };
        self.is_black = false;
        Some(passed)
    }

    /// Whether the token, which has come round to node 0, says that all is over.
    pub fn is_over(&self) -> bool {
        self.token.is_some_and(|token| !token.is_black && !self.is_black && token.count + self.count == 0)
    }

    /// The first token of a new round.
    pub fn begin(&mut self) -> Token {
        self.token = None;
        self.is_black = false;
        Token::default()
    }
}
