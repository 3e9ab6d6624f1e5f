function [result, info] = simulate(varargin)
% mbk.simulate  Simulate a trial; the recording contains the true M, B and K.
%
%   RESULT = mbk.simulate(...) returns the text that 'mbk simulate' prints.
%   [RESULT, INFO] = mbk.simulate(...) also returns INFO.text (the same text), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.simulate('relaxed_sinusoidal', 'out', 'relaxed.mat')
%   The first input is a ready scenario or a TOML file.
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run('simulate', varargin);
end
