function [result, info] = validate(varargin)
% mbk.validate  A method against known truth, as a table.
%
%   RESULT = mbk.validate(...) is the document that 'mbk validate --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.validate(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.validate('coverage', 'runs', 200, 'seed', 1)
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run('validate', varargin);
end
