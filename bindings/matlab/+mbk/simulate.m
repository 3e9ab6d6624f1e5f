function [result, info] = simulate(varargin)
% mbk.simulate  A simulated trial: a recording with the truth in it.
%
%   RESULT = mbk.simulate(...) is the document that 'mbk simulate --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.simulate(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.simulate('relaxed_sinusoidal', 'out', 'relaxed.mat')
%   a ready scenario or a TOML file; RESULT is the text that the program prints.
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run('simulate', varargin);
end
